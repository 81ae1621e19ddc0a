"""Planning problems: settings, objective and goals given by an end-effector pose."""
