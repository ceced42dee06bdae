"""Static beams, ideal and imperfect."""
