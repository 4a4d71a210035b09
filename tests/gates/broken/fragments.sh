# What a script does.
