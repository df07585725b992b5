"""FCDFS and its kin: the name by which world files call the program in `controllers.dispersal`."""

from controllers.dispersal.robot import main

if __name__ == "__main__":
    main()
