"""Files in and out: recordings as folders and .rrd files, declarations, models, waveforms, result folders."""
