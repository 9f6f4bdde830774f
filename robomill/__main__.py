"""``robomill`` and ``python -m robomill`` are the command line."""


def main() -> int:
    """Run it; whoever interrupts while it loads gets its exit code, too."""
    try:
        from robomill.cli import main as run

        return run()
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    raise SystemExit(main())
