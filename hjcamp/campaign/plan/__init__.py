"""From a campaign file and the call to the plan of a run or a sweep."""
