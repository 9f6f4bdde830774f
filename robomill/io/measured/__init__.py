"""What was measured: load tests, forces, profiles and maps."""
