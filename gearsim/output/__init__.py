"""Files people open: report, pictures, EXR, VTK, Parquet."""
