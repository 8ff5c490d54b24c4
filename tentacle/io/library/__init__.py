"""A library of recordings: the .rrd files stay the truth, an index beside them says what they are and what was found.

    from tentacle.io.library import open_library
    library = open_library(Path("recordings"))
    library.refresh()
    library.table()

Parquet by pyarrow, which Rerun brings, and no server: Rerun's own catalog needs one process more and datafusion
besides, and what is asked here (a few thousand rows of what was found) is answered from one file in milliseconds.
"""

from tentacle.io.library.library import Library, open_library
from tentacle.io.library.query import conditions

__all__ = ["Library", "conditions", "open_library"]
