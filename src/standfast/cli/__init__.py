"""The command line: one file a command; the only part that prints, exits or sets the environment.

:mod:`.app` reads the words and runs a command; :mod:`.running` is what commands that compute share.
"""
