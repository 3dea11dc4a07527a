"""A stream that a person looks at."""

import io


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True
