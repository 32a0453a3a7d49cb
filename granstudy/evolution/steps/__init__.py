"""Steps through time: of one size, or of sizes that adapt to their error; and states inside a step."""
