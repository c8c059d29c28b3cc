"""The library of effects, one small module each, by the stage they act at."""
