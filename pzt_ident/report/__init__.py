"""Tables, figures and the page of a finished run. Everything here reads results; nothing computes one."""
