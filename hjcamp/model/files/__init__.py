"""Files of users: where they are looked for, how they are loaded, how long they may take."""
