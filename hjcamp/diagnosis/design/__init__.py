"""The tests that would separate the models that are left."""
