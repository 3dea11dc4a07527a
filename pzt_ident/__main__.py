"""`python -m pzt_ident`."""

from pzt_ident.cli.commands import main

if __name__ == "__main__":
    main(prog_name="pzt-ident")
