"""Values in JSON and YAML files, and obstacles that other tools can hold."""
