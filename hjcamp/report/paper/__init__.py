"""What a run gives to a text: tables, figures, numbers as macros, and what to cite."""
