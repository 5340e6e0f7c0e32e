"""Scenes shipped with gearsim, one TOML file per worked example."""
