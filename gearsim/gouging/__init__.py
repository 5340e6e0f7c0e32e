"""Local gouging: whether a cutter fits a surface at a contact, in which directions it does not, which tool would."""
