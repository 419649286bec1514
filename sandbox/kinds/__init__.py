"""Facts that stand once: kinds of element, recorded arrays, quantities. Tables, and no spec."""
