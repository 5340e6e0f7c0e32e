"""Files of a run that generates surfaces: figures, report, maps and pictures."""
