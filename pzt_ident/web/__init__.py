"""What runs in a browser: plain modules without a build step, and uPlot as its makers ship it."""
