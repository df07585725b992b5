"""Entry of the controller `paint`: python -m controllers.paint --robots 4."""

from .program import main

if __name__ == "__main__":
    main()
