// A message that names an option of the program.
raise<config_error>(102, "--rate says it");
