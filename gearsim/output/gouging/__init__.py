"""Files of a run that sets predicted local gouging against the cut, and of worked examples."""
