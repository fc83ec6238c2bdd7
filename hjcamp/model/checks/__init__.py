"""What is checked of a plant and its effects before anybody relies on them."""
