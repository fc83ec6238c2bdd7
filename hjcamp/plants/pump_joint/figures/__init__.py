"""Figures of the joint and of chapter 3."""
