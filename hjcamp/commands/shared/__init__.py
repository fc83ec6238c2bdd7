"""What several commands share: their answers, pages, templates, progress and completions."""
