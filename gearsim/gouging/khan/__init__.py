"""Khan 1999: the worked examples of the thesis, its cases and its search for tool sizes, beside ours."""
