"""Two models of a soft arm in a tank, and the loop between them and measured data: the shared words."""
