"""The mechanism as every room sees it: kinds of element, recorded arrays, names worked out."""
