"""`python -m pzt_ident`."""

import os
import sys

if not sys.flags.safe_path and sys.path[0] == os.getcwd() != os.path.dirname(os.path.dirname(__file__)):
    del sys.path[0]  # like `pzt-ident`, it imports nothing that lies beside the data

if __name__ == "__main__":
    from pzt_ident.cli.commands import main

    main(prog_name="pzt-ident")
