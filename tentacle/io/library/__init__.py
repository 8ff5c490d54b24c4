"""A library of recordings: the .rrd files are the data, and an index beside them has their contents and verdicts.

    from tentacle.io.library import open_library
    library = open_library(Path("recordings"))
    library.refresh()
    library.table()

It uses Parquet by pyarrow, which Rerun installs, and no server. Rerun's own catalog would need a further process and
datafusion. The queries here (a few thousand rows) take milliseconds on one file.
"""

from tentacle.io.library.library import Library, open_library
from tentacle.io.library.query import conditions

__all__ = ["Library", "conditions", "open_library"]
