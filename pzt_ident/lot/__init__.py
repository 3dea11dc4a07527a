"""One job on a lot of devices.

In: a `Job`, and where the files of each device are. Out: a folder of results a device, one table of all of them
(`devices.parquet`, `devices.csv`), and a report on the lot: spreads, devices out of line, what they depend on.
"""
