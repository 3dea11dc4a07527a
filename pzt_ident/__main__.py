"""`python -m pzt_ident`."""

from pzt_ident.cli import main

if __name__ == "__main__":
    main(prog_name="pzt-ident")
