"""python -m experiments.unseen_labs cases|solve|table --out DIR --only a01,a02 --budget 60s --jobs 1"""

from experiments.other_labs.commands import main

from .names import NAMES
from .writing import write

if __name__ == "__main__":
    main("unseen_labs", NAMES, write)
