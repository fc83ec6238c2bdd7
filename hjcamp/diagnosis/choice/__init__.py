"""The choice of a model by nested cross-validation and a model confidence set; it runs in shadow of the decision's rules."""
