"""The shipped studies: each computes, draws and says what came out."""
