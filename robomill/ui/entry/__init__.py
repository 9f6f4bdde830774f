"""What people type and choose: number boxes, declared fields, the table that is edited."""
