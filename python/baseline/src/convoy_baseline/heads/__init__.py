"""What is found in features of the ground: boxes and masks, with their losses."""
