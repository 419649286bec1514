"""What no single element can see: names that lead somewhere, units that fit."""
