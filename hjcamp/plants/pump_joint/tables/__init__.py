"""Tables as data: what a model misses, judged by means and deviations of indicators alone."""
