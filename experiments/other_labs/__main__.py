"""python -m experiments.other_labs cases|solve|table --out DIR --only n01,n02 --budget 60s --jobs 1"""

from .commands import main
from .names import NAMES
from .writing import write

if __name__ == "__main__":
    main("other_labs", NAMES, write)
