"""One loop for all work that is done in shards: folder, lock, shards, estimate, log."""
