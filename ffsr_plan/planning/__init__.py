"""Planning: `plan`, `refine`, and the `Plan` that they return."""
