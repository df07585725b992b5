"""The live view: a page in the browser that shows a run, and hands that reach into it.

Nothing of this is imported, and no port is open, unless somebody asks for a view.

    watch.py      the only file that knows the engine: what it is at, and what hands do to it
    exchange.py   where the run's thread and the server's meet
    asks.py       what a page may ask for, checked
    server.py     the pages' connections, in a thread of their own
    entrance.py   who is let in, and the page's files
    opening.py    the command's side: addresses, the browser, one run after the other
    page/         the page: plain files, no build
"""
