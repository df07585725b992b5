"""The live view: a page in the browser that shows a run, and hands that reach into it.

Nothing of this is imported, and no port is open, unless somebody asks for a view.

    exchange.py   where the run's thread and the server's meet
    asks.py       what a page may ask for, checked
    server.py     the pages' connections (viewer.py), in a thread of their own
    messages.py   what they are sent (told.py: of that, the words and numbers)
    entrance.py   who is let in, and the page's files
    opening.py    the command's side: addresses, the browser, one run after the other
    window.py     a simulation that is stepped from Python, in the page
    page/         the page: plain files, no build

Of a run, which goes on in an engine:

    watch.py        hangs on to the engine, offers moments, obeys what pages ask for
    run_moments.py  what the run is at (readings.py: what its robots perceive; waits.py: how long
                    the world waited for them; scene.py: what does not change)
    hands.py        what hands do to it
    saved_world.py  a world file that begins as things stand

Of a log, which is over:

    playing.py      its clock
    log_moments.py  what the run was at (timeline.py: what happened, and when)
"""
