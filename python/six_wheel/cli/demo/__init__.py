"""The whole library on one real recording and one yard of rocks: `six-wheel demo`.

`motion` turns the recording into twists and drives rovers along them, `control` gives them to a controller as
commands, `ground` drives a rover over rocks, `figures` draws and tabulates, `running` joins them.
"""
