"""Studies of this joint on its simulated rig, and the pictures that its campaigns give."""
