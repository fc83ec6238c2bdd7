"""Prediction-error analysis of measured tests of any plant: residuals over windows, calibration, screening, verdict."""
