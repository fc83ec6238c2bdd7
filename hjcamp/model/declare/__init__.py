"""What plants and effects declare: states, inputs, parameters, places, laws."""
