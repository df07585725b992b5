"""Where there is room to go and to turn, which twist leads there, and where to look."""
