function(gust_embed_assets target)
endfunction()
