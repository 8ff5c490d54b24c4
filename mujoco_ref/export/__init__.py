"""The identified arm in files that MuJoCo reads without this project."""
