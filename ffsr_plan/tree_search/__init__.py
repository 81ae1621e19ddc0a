"""Planning in the whole configuration space by trees of motions."""
