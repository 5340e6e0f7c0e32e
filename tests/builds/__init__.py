"""Two builds of gearsim held against each other: every number that their runs of a scene leave behind."""
