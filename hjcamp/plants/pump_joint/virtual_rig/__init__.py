"""The virtual rig: the vendor's gRPC protocol in front of the plant, with faults that can be switched on."""
