"""The tests, laid out like the package."""

import os

# Matrices here are small: threads of BLAS only wait for each other. Set before NumPy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
